"""faying app [FOLDER]"""

from pathlib import Path

import click

from faying.cli.options import PATH


@click.command()
@click.argument("place", metavar="[FOLDER|STUDY]", type=PATH, default=".")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Port to listen on [a free one].")
@click.option("--open/--no-open", "opened", default=True, help="Open the page in the browser.")
def command(place: Path, port: int, opened: bool) -> None:
    """Open the project in FOLDER in the browser: view scan and geometry; edit, check and run the study.

    It works without a network. The address holds a token; nobody without it is let in. Ctrl-C ends it.
    """
    import webbrowser

    from faying.app.project import Project
    from faying.app.server import Server

    server = Server(Project.at(place), port)
    click.echo(f"{server.session.project.folder}\n{server.address}\nCtrl-C ends it.")
    if opened:
        webbrowser.open(server.address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        click.echo("")
    finally:
        server.close()
