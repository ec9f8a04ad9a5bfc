"""The rigid chain: the statics of any arm of rigid links, kinematics unknown."""
