"""The commands: parse, call the function of the same name, print. Everything heavy is imported inside them."""

# importing a module registers its commands, in the order of the help
from seatrial.cli import (  # noqa: F401, I001
    log_commands, trial_commands, model_commands, result_commands, campaign_commands, workspace_command,
    doctor_command,
)  # fmt: skip
from seatrial.cli.application import app

__all__ = ["app"]
