"""Ship motion models from sea-trial records, and controllers tuned on them.

    import seatrial as st

    trial = st.load_trial("examples/waterjet.toml")
    fit = st.identify(trial)

Functions (each also a command)
    load_trial    read and validate a trial file
    check         what is odd about the records: findings
    correct_trial correct a trial file by what the checks are certain of (command check --fix)
    draft_trial   draft a trial file from logs (command init)
    identify      estimate the model's coefficients, with intervals
    simulate      run a manoeuvre, or the inputs of a record, through a model
    predict       predict a measured run and compare it with the measurement
    design        design the manoeuvre that identifies the coefficients best
    compare       compare two fits: what differs between days, loadings, facilities or methods
    poster        wheelhouse poster and pilot card of a fit
    export        write a model as files of another tool: C99, FMU, CasADi, MATLAB, Gazebo
    tune          tune a feedback loop on a model
    verify        verify a tuned controller by the log of its trial (command tune --verify)
    follow        identify while the record is being made
    campaign      many identifications in a store: Monte Carlo, grids, runs left out, fleets
    benchmark     methods of estimation and optimisation against problems whose answer is known
    reproduce     repeat a published study
    demo          identify a craft with known coefficients
    list_models   the built-in and the installed models

Files
    read_record, write_record    records
    survey_log                   what is in a log
    Layout, ColumnSpec           how a record file of another program is laid out
    save, load, load_fit         result folders
    report                       the page of a result
    load_model, load_loop        model files, loop files

Values
    Record, Channel              one run; one of its channels
    Ship, Parameters, Prior      particulars; named values; Gaussian knowledge of one
    Model                        equations with parameters
    Sheet                        on which a model is written
    Trial, Run, Role             what is to be estimated; one of its records and what that is for
    EstimateSettings             how it is to be estimated
    Problem, Solution            a trial as an optimiser sees it; what an optimiser returns
    Fit, Design, Tuning, Study   results
    Finding, InputError          what a check reports; bad input, in one sentence

Subpackages
    models, manoeuvres, sea, control, optimisers, estimators, problems, testing

Names are imported when they are used first; ``__init__.pyi`` lists where each comes from.
"""

from seatrial._lazy import export_lazily

__version__ = "0.2.0"

export_lazily(__name__)
