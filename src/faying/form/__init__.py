"""How faces deviate from a plane: flatness, maps, crowns, waves."""
