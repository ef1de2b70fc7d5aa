"""Names of this package, imported when first used."""

from seatrial.workspace.server import serve_workspace as serve_workspace
from seatrial.workspace.server import workspace_beside as workspace_beside
from seatrial.workspace.shortcut import write_shortcut as write_shortcut
