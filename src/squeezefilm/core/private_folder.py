"""Refusal of folders in which others can write.

What is read back from a cache is believed, and what numba keeps there is run. So a folder in which
somebody else could put a file is neither read nor written, and this is said once.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import stat
from pathlib import Path

_log = logging.getLogger(__name__)
_told: set[Path] = set()


def is_shared(folder: Path, variable: str) -> bool:
    """True where a folder is there and somebody beside this user and root can write in it.

    If so, it is logged once, as a warning; `variable` is the environment variable that names
    another folder. Always False where files have no owner's number, as on Windows: each user has
    folders of their own there.
    """
    if not hasattr(os, "geteuid"):
        return False
    try:
        known = folder.stat()
    except OSError:
        return False
    reason = _shared_by(known)
    # One of many processes is enough to say it.
    if reason and folder not in _told and multiprocessing.parent_process() is None:
        _told.add(folder)
        _log.warning(
            "%s is not used, since %s: what is kept there is computed again. Make it yours alone "
            "(chown, chmod go-w), or let %s name a folder that is",
            folder,
            reason,
            variable,
        )
    return bool(reason)


def _shared_by(known: os.stat_result) -> str:
    """Words for who else can write there; empty where nobody can."""
    if known.st_uid not in (os.geteuid(), 0):
        return "it belongs to another user"
    if known.st_mode & stat.S_IWOTH:
        return "everybody can write in it"
    if known.st_mode & stat.S_IWGRP and not _is_own_group(known.st_gid):
        return "others of its group can write in it"
    return ""


def _is_own_group(number: int) -> bool:
    """True for a group that is the one that many systems make for each user, with nobody else in
    it."""
    import grp
    import pwd

    try:
        group, own = grp.getgrgid(number), pwd.getpwuid(os.geteuid()).pw_name
    except KeyError:
        return False
    return group.gr_name == own and set(group.gr_mem) <= {own}
