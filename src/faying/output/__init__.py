"""What a person sees of a result: tables, figures, the report."""
