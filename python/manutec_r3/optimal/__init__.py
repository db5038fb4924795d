"""Motions that are optimal for the arm: between least time and least effort.

They need CasADi, which brings IPOPT: ``pip install "manutec-r3[optimal]"``.
"""
