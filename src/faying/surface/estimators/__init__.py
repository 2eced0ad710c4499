"""One estimator of D and G a file; `table` lists them."""
