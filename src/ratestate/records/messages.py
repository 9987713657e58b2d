"""Load the messages.toml of each package of `records`."""

from pathlib import Path

from ..model.names import Sentences

fitting, healing, kit, load_point, machine, reading, stick_slip = (
    Sentences(Path(__file__).with_name(package) / "messages.toml")
    for package in ("fitting", "healing", "kit", "load_point", "machine", "reading", "stick_slip")
)
raw_record = Sentences(Path(__file__).with_name("raw_record.toml"))
