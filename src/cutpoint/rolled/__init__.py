"""Large robots: their equations as loops over bodies, compiled once for a tree of any size."""

from cutpoint.rolled.functions import RolledFunction, rolled
from cutpoint.rolled.recipes import RECIPES

__all__ = ["RECIPES", "RolledFunction", "rolled"]
