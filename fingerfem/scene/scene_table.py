"""The base of every table of a scene."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class SceneTable(BaseModel):
    """A table of the scene: every key known, nothing converted silently, nothing changed afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
