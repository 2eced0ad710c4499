"""The contact laws, one file each; `faying.contact.laws()` lists those that it finds here."""
