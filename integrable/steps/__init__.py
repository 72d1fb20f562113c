"""Bäcklund maps: translations, moves and their compositions, with as many guard digits as they need."""
