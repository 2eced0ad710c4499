"""Commands about a scan and the laws that follow from it."""
