"""STEP files: solids, faces, holes and seats, and how a study names them."""
