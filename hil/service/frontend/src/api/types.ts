// The API's types, by the names the page uses; schema.d.ts is made of docs/reference/openapi.json by the build.

import type { components } from "./schema.d.ts";

type Schemas = components["schemas"];

export type Bench = Schemas["BenchData"];
export type Run = Schemas["RunData"];
export type Plan = Schemas["PlanData"];
export type Forecast = Schemas["ForecastData"];
export type Me = Schemas["Me"];
export type Health = Schemas["Health"];
export type Problem = Schemas["Problem"];

export const ROLES = ["viewer", "operator", "engineer", "admin"] as const;
export type Role = (typeof ROLES)[number];
export type RunView = Schemas["RunViewData"];
export type Mark = Schemas["MarkData"];
export type LimitLine = Schemas["LimitLine"];
export type Criterion = Schemas["PredictedCriterion"];
export type RunTraces = Schemas["RunTraces"];
export type RunSpectrum = Schemas["RunSpectrum"];
export type RunSamples = Schemas["RunSamples"];
export type FoundRuns = Schemas["FoundRuns"];
export type FoundRun = Schemas["FoundRun"];
export type RunChoices = Schemas["RunChoices"];
export type Trend = Schemas["TrendData"];
export type Comparison = Schemas["ComparisonData"];
export type Model = Schemas["ModelData"];
export type Controller = Schemas["ControllerData"];
export type Study = Schemas["StudyData"];
export type Diagnosis = Schemas["DiagnosisData"];
export type Campaign = Schemas["CampaignData"];
export type AuditEntry = Schemas["AuditEntry"];
export type TokenData = Schemas["TokenData"];
export type TokenMade = Schemas["TokenMade"];
export type Agent = Schemas["AgentData"];
export type KeptApart = Schemas["KeptApart"];
export type Layout = Schemas["LayoutData"];
export type DraftData = Schemas["DraftData"];
export type DesignData = Schemas["DesignData"];
export type Identification = Schemas["IdentificationData"];
export type CampaignExample = Schemas["CampaignExample"];
export type CampaignFindings = Schemas["CampaignFindings"];
export type Prompt = Schemas["PromptData"];
export type RunNotes = Schemas["RunNotes"];
export type Note = Schemas["NoteData"];
export type PlanCheck = Schemas["PlanCheck"];
export type PlanMistake = Schemas["PlanMistake"];
export type CloudData = Schemas["CloudData"];
export type SegmentsData = Schemas["SegmentsData"];
