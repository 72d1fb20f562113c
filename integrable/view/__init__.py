"""The page that moves: one HTML file of a motion, with the ball on its plane, γ, two points on the curve, the torus.

``shown`` computes what the page holds, ``ovals`` where the divisor's points are and the angles of the torus, ``page``
writes the file.
"""
