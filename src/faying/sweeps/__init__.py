"""Many preloads, surfaces and laws of one study."""
