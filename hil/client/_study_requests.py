"""Identifications, diagnoses and campaigns."""

from __future__ import annotations

from pathlib import Path

from hil.api_schemas.campaign import CampaignData, CampaignExample, CampaignFindings, CampaignWanted
from hil.api_schemas.study import (
    DiagnosisData,
    DiagnosisWanted,
    IdentificationData,
    IdentificationWanted,
    StudyData,
)
from hil.client._requests import Requests, part

_FORECAST_WITHIN_S = 300.0


class StudyRequests(Requests):
    """Identifications, diagnoses and campaigns."""

    def identify(self, wanted: IdentificationWanted) -> StudyData:
        """Have a model identified from runs; `study` tells how it goes."""
        return self._one(StudyData, "POST", "/identifications", wanted)

    def diagnose(self, wanted: DiagnosisWanted) -> StudyData:
        """Have it found out why runs and a model differ; `study` tells how it goes."""
        return self._one(StudyData, "POST", "/diagnoses", wanted)

    def studies(self) -> list[StudyData]:
        """Identifications, diagnoses and tunings, newest first."""
        return self._several(StudyData, "/studies")

    def study(self, study: int) -> StudyData:
        """An identification, a diagnosis or a tuning."""
        return self._one(StudyData, "GET", f"/studies/{study}")

    def cancel_study(self, study: int) -> StudyData:
        """End one; a diagnosis writes what it knows by then."""
        return self._one(StudyData, "POST", f"/studies/{study}/cancel")

    def remove_study(self, study: int) -> None:
        """Remove one that is over, with its files."""
        self._done("DELETE", f"/studies/{study}")

    def download_of_study(self, study: int, name: str, path: Path) -> None:
        """Write a file of a study that is over, whole or not at all: a report, a model, a controller.

        Raises:
            BadInputError: the place cannot be written.
        """
        self._download(f"/studies/{study}/files/{part(name)}", path)

    def identification(self, study: int) -> IdentificationData:
        """What an identification found."""
        path = f"/identifications/{study}"
        return self._one(IdentificationData, "GET", path, within_s=_FORECAST_WITHIN_S)

    def diagnosis(self, study: int) -> DiagnosisData:
        """What a diagnosis found."""
        return self._one(DiagnosisData, "GET", f"/diagnoses/{study}")

    def campaign_examples(self) -> list[CampaignExample]:
        """The built-in campaigns."""
        return self._several(CampaignExample, "/campaign-examples")

    def add_campaign(self, wanted: CampaignWanted) -> CampaignData:
        """Have a campaign executed; `campaign` tells how it goes."""
        return self._one(CampaignData, "POST", "/campaigns", wanted, within_s=_FORECAST_WITHIN_S)

    def campaigns(self) -> list[CampaignData]:
        """Campaigns, newest first."""
        return self._several(CampaignData, "/campaigns")

    def campaign(self, campaign: int) -> CampaignData:
        """A campaign, with its progress and the shares that pass so far."""
        return self._one(CampaignData, "GET", f"/campaigns/{campaign}")

    def campaign_findings(self, campaign: int) -> CampaignFindings:
        """What a campaign that is over came to."""
        return self._one(CampaignFindings, "GET", f"/campaigns/{campaign}/findings")

    def cancel_campaign(self, campaign: int) -> CampaignData:
        """End one; what is under way is awaited and kept, unless this is asked twice."""
        return self._one(CampaignData, "POST", f"/campaigns/{campaign}/cancel")

    def resume_campaign(self, campaign: int) -> CampaignData:
        """Go on with one that was cancelled or has failed."""
        return self._one(CampaignData, "POST", f"/campaigns/{campaign}/resume")

    def remove_campaign(self, campaign: int) -> None:
        """Remove one that is over, with its files."""
        self._done("DELETE", f"/campaigns/{campaign}")

    def download_of_campaign(self, campaign: int, name: str, path: Path) -> None:
        """Write a file of a campaign, whole or not at all.

        Raises:
            BadInputError: the place cannot be written.
        """
        self._download(f"/campaigns/{campaign}/files/{part(name)}", path)
