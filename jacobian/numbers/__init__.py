"""The number types that compiled code uses: words, tables of small fields, double-doubles, long reals."""
