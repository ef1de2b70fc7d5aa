"""Names of this package, imported when first used."""

from seatrial.data.example_series.files import write_demo as write_demo
from seatrial.data.example_series.series import (
    JET_VELOCITY as JET_VELOCITY,
    SENSOR_NOISE as SENSOR_NOISE,
    SLEW_RATE as SLEW_RATE,
    demo_series as demo_series,
    simulate_run as simulate_run,
    true_model as true_model,
    with_sensor_noise as with_sensor_noise,
    write_csv as write_csv,
)
