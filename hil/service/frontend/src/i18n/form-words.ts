// What the service's schemas say of the fields of a campaign, in the page's words.

import { said, type Phrase } from "./said.ts";

export const FORM_WORDS: Phrase[] = [
  said("name of the results; letters, digits, _, - and ., at most 64"),
  said("title of the report"),
  said("purpose"),
  said("vehicles sampled around each model; 0: the model alone"),
  said("random seed of the draws and of sensor noise"),
  said("required pass rate of each controller, 0 to 1"),
  said("motor inertia, half width, relative"),
  said("gear ratio, half width, relative"),
  said("vehicle inertia, half width, relative"),
  said("viscous drag, half width, relative"),
  said("torque delay, half width, relative"),
  said("shaft stiffness, half width, relative"),
  said("shaft damping, half width, relative"),
  said("wheel inertia, half width, relative"),
  said("tyre stiffness, half width, relative"),
  said("tyre damping, half width, relative"),
  said("dead time s"),
  said("backlash rad"),
  said("order phase"),
  said("sensor noise"),
];
