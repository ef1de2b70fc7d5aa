"""Names of this package, imported when first used."""

from seatrial.campaigns.store import Store as Store, open_store as open_store
from seatrial.campaigns.work import Row as Row, Task as Task, Work as Work
