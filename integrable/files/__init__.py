"""Arrays with names and units, for xarray, pandas and files; each file is complete or absent."""
