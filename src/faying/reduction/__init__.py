"""Small bases in which a joint changes at little cost."""
