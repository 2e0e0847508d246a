"""The base of every table of a scene."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Length = Annotated[float, Field(ge=1e-6, le=1.0)]  # [m]; a length above 1 m is a length in mm


class SceneTable(BaseModel):
    """A table of the scene: every key known, nothing converted silently, nothing changed afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
