"""The reduced absorber: a cavity that is shaken harmonically."""
