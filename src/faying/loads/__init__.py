"""Load cases on a preloaded structure: statics, forces of bolts, opening, slip, intervals, record, table, figure."""
