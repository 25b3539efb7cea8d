"""The question "which floor is this photograph?", asked from pixels alone."""
