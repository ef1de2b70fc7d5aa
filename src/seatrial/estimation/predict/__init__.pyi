"""Names of this package, imported when first used."""

from seatrial.estimation.predict.windows import HoldoutProtocol as HoldoutProtocol, WindowError as WindowError
from seatrial.estimation.predict.windows import split_windows as split_windows, window_errors as window_errors
from seatrial.estimation.predict.prediction_intervals import band_errors as band_errors
from seatrial.estimation.predict.draws import measure_intervals as measure_intervals
from seatrial.estimation.predict.open_loop import predict_run as predict_run, simulate_open_loop as simulate_open_loop
from seatrial.estimation.predict.predict_runs import predict_runs as predict_runs
from seatrial.estimation.predict.predict_runs import prediction_uncertainty as prediction_uncertainty
from seatrial.estimation.predict.prediction_intervals import holdout_model as holdout_model
from seatrial.estimation.predict.session_offsets import session_offsets as session_offsets
from seatrial.estimation.predict.windows import Windows as Windows
