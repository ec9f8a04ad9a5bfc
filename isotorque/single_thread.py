"""Linear algebra in one thread: results do not depend on the number of processors."""

from isotorque.symbolic.common.single_thread import single_thread as single_thread
