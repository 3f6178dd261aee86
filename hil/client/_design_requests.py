"""Plans, models, controllers and pictures, and what is designed with them."""

from __future__ import annotations

import hashlib

from hil.api_schemas.api import PlanData
from hil.api_schemas.design import (
    CloudData,
    CloudWanted,
    ControllerData,
    DesignData,
    DraftData,
    DraftWanted,
    ModelData,
    PlanCopyWanted,
    SegmentsData,
    SegmentsWanted,
)
from hil.api_schemas.upload import KeptApart
from hil.client._requests import WITHIN_S, Requests, part

_FORECAST_WITHIN_S = 300.0


class DesignRequests(Requests):
    """Plans, models and controllers, and what is designed with them."""

    def plans(self) -> list[PlanData]:
        """All plans."""
        return self._several(PlanData, "/plans")

    def give_plan(self, name: str, text: str, instead_of: str | None = None) -> PlanData:
        """Give a plan (YAML), or replace one that was given.

        Args:
            instead_of: the text that it replaces, '' if there is to be none: another one that was saved
                meanwhile is refused. None replaces whatever is there.
        """
        query = ""
        if instead_of is not None:
            sha256 = hashlib.sha256(instead_of.encode()).hexdigest() if instead_of else ""
            query = f"?instead_of={sha256}"
        return self._one(PlanData, "PUT", f"/plans/{part(name)}{query}", text)

    def copy_plan(self, plan: str, wanted: PlanCopyWanted) -> PlanData:
        """Give a copy of a plan that loads other controllers."""
        return self._one(PlanData, "POST", f"/plans/{part(plan)}/copies", wanted)

    def kept_apart(self) -> list[KeptApart]:
        """Files of an earlier version's folder that the service has kept as they are, and does not share."""
        return self._several(KeptApart, "/kept-apart")

    def models(self) -> list[ModelData]:
        """All models."""
        return self._several(ModelData, "/models")

    def give_model(self, name: str, text: str) -> ModelData:
        """Give a model file."""
        return self._one(ModelData, "PUT", f"/models/{part(name)}", text)

    def controllers(self) -> list[ControllerData]:
        """All controllers."""
        return self._several(ControllerData, "/controllers")

    def give_controller(self, name: str, text: str) -> ControllerData:
        """Give a controller file, so that plans can load it."""
        return self._one(ControllerData, "PUT", f"/controllers/{part(name)}", text)

    def give_picture(self, name: str, content: bytes) -> None:
        """Give a picture, so that prompts of plans can show it."""
        with self._opened("PUT", f"/pictures/{part(name)}", content, WITHIN_S):
            pass

    def draft(self, wanted: DraftWanted) -> DraftData:
        """Loops, margins and steps of a controller on a model."""
        return self._one(DraftData, "POST", "/drafts", wanted, within_s=_FORECAST_WITHIN_S)

    def draft_cloud(self, wanted: CloudWanted) -> CloudData:
        """A draft on cars drawn around its model."""
        return self._one(CloudData, "POST", "/drafts/clouds", wanted, within_s=_FORECAST_WITHIN_S)

    def draft_segments(self, wanted: SegmentsWanted) -> SegmentsData:
        """Margins of a plan's controllers and of a draft in each segment."""
        return self._one(SegmentsData, "POST", "/drafts/segments", wanted, within_s=_FORECAST_WITHIN_S)

    def design(self, wanted: DraftWanted) -> DesignData:
        """A controller's file, judged on every plant that the model's uncertainty allows."""
        return self._one(DesignData, "POST", "/designs", wanted, within_s=_FORECAST_WITHIN_S)
