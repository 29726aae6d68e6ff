"""How pickled objects are made again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypedDict

from ._radsight import Capture, JobResult, RenderJob, Scene


def scene(texts: Sequence[tuple[str, bytes]], files: Mapping[str, bytes], materials: Mapping[str, object]) -> Scene:
    return Scene(texts, files=files, materials=materials)


class _CaptureOptions(TypedDict):
    error: float | None
    samples: int | None
    seed: int
    ambient_bounces: int
    threads: int | None


def capture(name: str, text: bytes, files: Mapping[str, bytes], options: _CaptureOptions) -> Capture:
    return Capture.from_text(text.decode(), name=name, files=files, **options)


def job(text: str) -> RenderJob:
    return RenderJob.from_json(text)


def result(data: bytes) -> JobResult:
    return JobResult.from_bytes(data)
