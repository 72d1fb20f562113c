"""An animated page: one HTML file of a motion, with the ball on its plane, γ, two points on the curve, and the torus.

``shown`` computes its data, ``ovals`` the divisor's points and the angles of the torus, ``page`` writes the file.
"""
