"""Built-in and declared machines: one file for each; `base` and `varying` are their common bases, `names` their names."""
