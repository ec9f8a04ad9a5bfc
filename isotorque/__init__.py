"""Isotorque: the statics of robot arms and their symmetries."""
