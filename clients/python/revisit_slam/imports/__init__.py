"""Maps of other systems: their files become recordings that `revisit replay` plays."""
