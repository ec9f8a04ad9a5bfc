"""Discovery: motor babbling and torque profiles (Algorithm 1)."""
