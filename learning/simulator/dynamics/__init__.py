"""Equations of motion of an arm and the two engines that integrate them."""
