"""Arrays with names and units, as xarray, pandas and files have them; each file complete or not there."""
