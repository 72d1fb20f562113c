"""Bäcklund maps: translations, moves and their compositions, with the guard digits they need."""
