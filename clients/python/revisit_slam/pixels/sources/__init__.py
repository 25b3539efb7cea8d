"""Sources: where photographs come from, and what each source knows of them."""
