"""Which compiled libraries are found and which are refused. The files here hold text: what opens them is the test's."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from liftopt.collocation.codegen import kernel_cache
from liftopt.collocation.codegen.kernel_cache import LIBRARY_NAME, UNUSED_DAYS, cache_folder, find_library, keep
from liftopt.files.checksum import DIGEST_BYTES

KEY, OTHER = "0123456789abcdef" * 2, "f" * 32
needs_owners = pytest.mark.skipif(not hasattr(os, "getuid"), reason="no owners on this system")


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an installed package with an empty folder of kernels."""
    monkeypatch.setattr(kernel_cache, "PACKAGE", tmp_path / "package")
    (tmp_path / "package" / "kernels").mkdir(parents=True)
    (tmp_path / "package").chmod(0o755)
    return tmp_path / "package" / "kernels"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the user's cache folder, not made yet."""
    monkeypatch.setenv("LIFTOPT_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def put(folder: Path, content: str, key: str = KEY) -> Path:
    """Put a library with its checksum into a folder."""
    folder.mkdir(exist_ok=True)
    path = folder / f"{key}.so"
    path.write_text(content)
    kernel_cache._add_checksum(path)
    return path


def content(path: Path) -> str:
    """Open a library: what it holds but for its checksum."""
    return path.read_bytes()[:-DIGEST_BYTES].decode()


def test_the_package_comes_first_then_the_cache(package: Path, cache: Path) -> None:
    assert find_library(KEY, content) is None
    put(cache, "from the cache")
    assert find_library(KEY, content) == "from the cache"
    put(package, "from the package").chmod(0o644)
    assert find_library(KEY, content) == "from the package"
    assert find_library(OTHER, content) is None


def test_a_damaged_library_of_the_package_is_passed_over(package: Path, cache: Path) -> None:
    put(cache, "from the cache")
    path = put(package, "from the package")
    path.write_bytes(b"x" + path.read_bytes()[1:])
    assert find_library(KEY, content) == "from the cache"


def test_a_library_of_the_package_that_does_not_open_is_passed_over(package: Path, cache: Path) -> None:
    """As one that is linked with what this system lacks."""
    put(cache, "from the cache")
    put(package, "from the package")
    assert find_library(KEY, lambda path: None if path.parent == package else content(path)) == "from the cache"


@needs_owners
@pytest.mark.parametrize(
    ("of_package", "of_library", "trusted"), [(0o755, 0o644, True), (0o755, 0o664, False), (0o775, 0o664, True)]
)
def test_a_library_of_the_package_is_trusted_as_far_as_its_code(
    of_package: int, of_library: int, trusted: bool, package: Path, cache: Path
) -> None:
    """Who can write to the package's folder can change its code; a library that more people can write to is refused."""
    put(package, "from the package").chmod(of_library)
    package.parent.chmod(of_package)
    assert find_library(KEY, content) == ("from the package" if trusted else None)


@needs_owners
def test_a_library_of_the_package_may_be_the_administrators(
    package: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seen by another user the package's is found, for its owner is the code's, and the cache's is not."""
    put(package, "from the package")
    put(cache, "from the cache", OTHER)
    monkeypatch.setattr(os, "getuid", lambda: package.stat().st_uid + 1)
    assert find_library(KEY, content) == "from the package"
    assert cache_folder() is None
    assert find_library(OTHER, content) is None


@needs_owners
@pytest.mark.parametrize("mode", [0o622, 0o660])
def test_a_library_of_the_cache_that_others_can_write_is_refused(mode: int, package: Path, cache: Path) -> None:
    put(cache, "from the cache").chmod(mode)
    assert find_library(KEY, content) is None


def test_what_no_run_has_loaded_for_long_goes_when_something_new_is_kept(
    package: Path, cache: Path, tmp_path: Path
) -> None:
    """A library that was loaded meanwhile stays, and so does what is no library of ours."""
    long_ago = time.time() - 86400.0 * (UNUSED_DAYS + 1.0)
    used, unused = put(cache, "used"), put(cache, "unused", OTHER)
    foreign, unsealed = cache / "notes.so", cache / f"{'a' * 32}.so"
    for path in (foreign, unsealed):
        path.write_text("not ours")
    for path in (used, unused, foreign, unsealed):
        os.utime(path, (long_ago, long_ago))
    assert find_library(KEY, content) == "used"
    built = tmp_path / f"{'b' * 32}.so"
    built.write_text("new")
    assert keep(built, cache_folder(), content) == "new"
    assert LIBRARY_NAME.fullmatch(built.name)
    assert {path.name for path in cache.iterdir()} == {used.name, foreign.name, unsealed.name, built.name}


def test_a_library_without_a_folder_is_opened_where_it_was_built(tmp_path: Path) -> None:
    built = tmp_path / "built.so"
    built.write_text("new")
    assert keep(built, None, content) == "new"
