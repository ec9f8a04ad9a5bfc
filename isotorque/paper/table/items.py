"""All rows of the table, in the order of the paper."""

from __future__ import annotations

from isotorque.paper.table.items_batch import BATCH_2R, BATCH_3R
from isotorque.paper.table.items_online import FACTOR, ONLINE_2R, ONLINE_3R, TIMES
from isotorque.paper.table.items_statics import (
    BCTS,
    DISCOVERY_2R,
    DISCOVERY_3R,
    RANGES_2R,
    RANGES_3R,
    STATIC_TORQUES,
    SYMMETRIES,
)

ITEMS = (
    *SYMMETRIES,
    *DISCOVERY_2R,
    *DISCOVERY_3R,
    *BCTS,
    *STATIC_TORQUES,
    *RANGES_2R,
    *ONLINE_2R,
    *FACTOR,
    *TIMES,
    *RANGES_3R,
    *ONLINE_3R,
    *BATCH_2R,
    *BATCH_3R,
)
