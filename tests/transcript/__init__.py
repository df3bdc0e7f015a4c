"""The numbered equations of Xia et al. (2019), IEEE Access 7, in plain NumPy, for the package to be held against.

Shares no code with the package.  The paper's symbols throughout: spatial vectors are (6,) with the linear part first,
in the frame of their body; `z` is the sixth unit vector; one state at a time.  `paper.py` collects the functions.
"""
