"""Sources: where photographs come from, and what each source knows of them."""

from .source import Source

__all__ = ["Source"]
