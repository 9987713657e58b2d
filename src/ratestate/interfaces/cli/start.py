"""The commands `init` and `explore`."""

import os
import shlex
from pathlib import Path

import typer

from ...errors import ParameterError
from ...scenario import templates
from ..explorer import explorer_package
from .exits import INTERRUPTED
from .options import register_file
from .output import print_line


def init(kind: str = "lab", *, out: Path | None = None, listing: bool = False) -> None:
    """Write a commented scenario file to start from, and the data that it needs.

    Example: ratestate init brake
    """
    if listing:
        width = max(map(len, templates.TEMPLATES))
        for name in templates.TEMPLATES:
            print_line(f"{name:{width}}  {templates.description(name)}")
        return
    texts = templates.files_of(kind)
    template_file = f"{kind}.toml"
    if out == Path("-"):
        print_line(texts[template_file].rstrip("\n"))
        return
    path = (out or Path(template_file)).expanduser()
    if path.suffix.lower() != ".toml":
        raise typer.BadParameter(f"{str(path)!r} does not end in .toml", param_hint="--out")
    places = {file: path if file == template_file else path.with_name(file) for file in texts}
    _write({places[file]: text for file, text in texts.items()})
    print_line(f"wrote {' and '.join(map(str, places.values()))}\nNext:")
    for line in templates.commands(kind):
        for file, path_of_file in places.items():
            line = line.replace(f" {file}", f" {shlex.quote(str(path_of_file))}")
        print_line(f"  {line}")


def _write(texts: dict[Path, str]) -> None:
    """Write all of these files, or none if one exists or cannot be written."""
    from ...files import checked_path, replace

    for path in texts:
        if os.path.lexists(path):
            other = "name" if path.suffix.lower() == ".toml" else "folder"
            raise ParameterError(f"{path} exists", f"Give another {other} with --out.")
    places = {checked_path(path, (path.suffix.lower(),)): text for path, text in texts.items()}
    written = list[Path]()
    try:
        for path, text in places.items():
            replace(path, lambda partial, text=text: partial.write_text(text, "utf-8"))
            written.append(path)
    except BaseException:
        for path in written:
            path.unlink()
        raise


def explore(
    file: Path | None = None,
    *,
    law_file: Path | None = None,
    port: int | None = None,
    no_browser: bool = False,
    save: Path | None = None,
) -> None:
    """Open the explorer in the browser: change parameters and watch the motion.

    No data leave this machine.  Ctrl-C ends the explorer.  With --save it is written to an HTML
    file, which opens without a server.

    Example: ratestate explore --port 8765
    """
    explorer = explorer_package()
    if file is None:
        register_file(law_file)
        opened = None
    else:
        opened = _opened(file, law_file)
    if save is not None:
        if port is not None or no_browser:
            given = "--port" if port is not None else "--no-browser"
            raise ParameterError(
                f"{given} cannot be used with --save, which writes a file and starts no server",
                "Leave out one of them.",
            )
        if opened:
            path = explorer.Page(*opened).save(save)
        else:
            path = explorer.save_page(save, explorer.presets()[0]["entries"])
        print_line(f"wrote {path}", err=True)
        return
    try:
        fragment = explorer.fragment_of(*opened) if opened else ""
        explorer.serve(port=port, open_browser=not no_browser, fragment=fragment)
    except KeyboardInterrupt:
        typer.echo("interrupted: the explorer has ended", err=True)
        os._exit(INTERRUPTED)  # at once, without waiting for threads that compute or compile


def _opened(file, law_file):
    """Return the slider and the last speed of a scenario file."""
    from .run_scenario import load_scenario, swept_dims

    scenario = load_scenario(file, "stability", law_file)
    if swept := swept_dims(scenario):
        raise ParameterError(
            f"[sweep]: the file has a sweep over {', '.join(swept)}, but the explorer "
            "shows one slider",
            f"Give a file without [sweep], or run it with ratestate run {file}.",
        )
    return scenario.slider, scenario.settings["V_lp"]
