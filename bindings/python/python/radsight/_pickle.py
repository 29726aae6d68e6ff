"""How pickled objects are made again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ._radsight import Capture, JobResult, RenderJob, Scene


def scene(texts: Sequence[tuple[str, bytes]], files: Mapping[str, bytes], materials: Mapping[str, object]) -> Scene:
    return Scene(texts, files=files, materials=materials)


def capture(
    name: str,
    text: bytes,
    files: Mapping[str, bytes],
    asked: tuple[float, int | None, int, int],
    threads: int | None,
) -> Capture:
    error, samples, seed, ambient_bounces = asked
    return Capture.from_text(
        text.decode(),
        name=name,
        files=files,
        error=error,
        samples=samples,
        seed=seed,
        ambient_bounces=ambient_bounces,
        threads=threads,
    )


def job(text: str) -> RenderJob:
    return RenderJob.from_json(text)


def result(data: bytes) -> JobResult:
    return JobResult.from_bytes(data)
