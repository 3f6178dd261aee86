"""Thresholds of the search: what is looked for, what a name must earn."""

from __future__ import annotations

from typing import Annotated

from hil.analysis.diagnosis.threshold import Means

ALIGNMENT_ROUNDS: Annotated[int, Means("rounds", "of tracking and fitting at most", "alignment")] = 4
ALIGNMENT_LITTLE: Annotated[
    float, Means("of what is left", "a round that gains less is the last", "alignment")
] = 0.02
ZERO_DOUBTED: Annotated[
    float,
    Means("of pure noise", "left by a model with ripples: maybe they count from another angle", "alignment"),
] = 0.02
ZERO_WRONG: Annotated[
    float, Means("of what is left", "another zero that leaves less is the right one", "alignment")
] = 0.5
WHOLE_ORDER: Annotated[
    tuple[float, float],
    Means("orders", "an order so far from a whole one may be that one, bent by drift", "alignment"),
] = (0.002, 0.15)
WHOLE_WORSE: Annotated[
    float,
    Means(
        "times what another order leaves",
        "a whole order may leave: drift that was followed makes up for more",
        "alignment",
    ),
] = 1.02

BOOTSTRAP_DRAWS: Annotated[
    int, Means("draws", "of the bootstrap: one in twenty false names would be seen", "by_chance")
] = 19
ENOUGH_S: Annotated[
    float,
    Means("s", "of recordings that the bootstrap looks at: noise scores no more in longer ones", "by_chance"),
] = 45.0

NEARLY: Annotated[
    float, Means("of the whole gap", "once it is closed, what is left may be a formula that differs", "blind")
] = 0.93
SIGMAS: Annotated[
    float, Means("standard deviations of noise's own", "physics below it is none", "evidence")
] = 5.0
NOTHING: Annotated[
    float, Means("of a channel's noise power", "physics below it is none: 1 % of gap", "evidence")
] = 0.02
SMALL: Annotated[
    float, Means("gap over noise floor", "below it no further effect is missing", "evidence")
] = 1.03
SMALLISH: Annotated[
    float, Means("gap over noise floor", "the same, once 99 % of the gap are closed", "evidence")
] = 1.1
LAWS_DIFFER: Annotated[
    float,
    Means(
        "gap over noise floor", "the same for contact, dry friction and hysteresis: formulas differ", "blind"
    ),
] = 1.25
WHITE_AT_LEAST: Annotated[
    float, Means("of the white noise", "is in any error: its level is known to a few per cent", "evidence")
] = 0.95
NEARLY_ALL: Annotated[
    float, Means("of the whole gap", "once it is closed a little more may be left", "evidence")
] = 0.99

ALL_BUT: Annotated[
    float,
    Means(
        "of the whole gap",
        "once contact or friction close it no further effect is missing; steps of time leave 1e-5 to 7e-5 of "
        "a hidden play of 0.01 and 0.02 rad",
        "predicted",
    ),
] = 0.9998
ALL_BUT_NOISES: Annotated[
    float, Means("gap over noise floor", "if it leaves no more in any channel", "predicted")
] = 4.0
LEAST_EVIDENCE: Annotated[
    float, Means("squared error, noise variances", "a name must take off more, after deflation", "blind")
] = 30.0
FAR: Annotated[
    float,
    Means("noise powers", "with more left formulas differ, and a fault in a sensor is doubted", "rank"),
] = 50.0
DOUBT: Annotated[
    float, Means("factor of the total", "price of a fault in a sensor far from the noise", "rank")
] = 2.5
EARLY: Annotated[
    float,
    Means("factor of the total", "price of a channel that is early: it is others that are late", "rank"),
] = 1.005
CONTENDER: Annotated[
    float, Means("times what the best leaves", "far from the noise its optional numbers are tried too", "far")
] = 1.5
PRICE: Annotated[
    float,
    Means(
        "squared error, noise variances",
        "of each number that an effect brings, when two effects explain the same",
        "rank",
    ),
] = 8.0
PLAIN: Annotated[
    float,
    Means("of the remaining gap", "if no score promises it, nominal parameters are tried too", "hidden"),
] = 0.5
STRAIGHT: Annotated[
    float,
    Means("times what is left", "nominal parameters that leave more say nothing of what lacks", "hidden"),
] = 30.0
HOPE: Annotated[
    float, Means("of the remaining gap", "the best linearised score must promise it", "hidden")
] = 0.1
HOPE_FURTHER: Annotated[
    float,
    Means(
        "of the remaining gap",
        "the same beside effects that were found: of 19 hidden pairs the second promises 0.75 or more",
        "blind",
    ),
] = 0.3
SIZES: Annotated[
    tuple[float, ...],
    Means("factor", "sizes of an effect that are tried, around what its probe says", "hidden"),
] = (0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0)
HIDDEN_SPEEDS_RAD_S: Annotated[
    tuple[float, ...],
    Means("rad/s, rotor", "that a recording without a speed channel may begin at, either way", "hidden"),
] = (5.0, 20.0, 50.0, 100.0, 200.0)
WIDTHS: Annotated[
    tuple[float, ...], Means("factor", "widths of a play that are tried, each with its places", "hidden")
] = (0.5, 0.7, 0.87, 1.15, 1.4, 2.0)
PLACES_NM: Annotated[
    tuple[float, ...],
    Means("N m", "torques whose place in the play a recording may begin in", "hidden"),
] = (-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0)
PLACES_WORTH: Annotated[
    float, Means("times what is left", "another width with its places must leave less to be fitted", "hidden")
] = 1.5
PLACES_MIDDLING: Annotated[
    float,
    Means(
        "times what is left",
        "another width that leaves more in half of all windows is wrong in any place",
        "width",
    ),
] = 3.0
PLACES_TRIED: Annotated[int, Means("widths", "are fitted at a time", "hidden")] = 4
PLACE_ROUNDS: Annotated[int, Means("times", "widths and places are looked for anew", "hidden")] = 3
PLACE_STEPS: Annotated[
    int, Means("rounds", "after which other widths are left that are behind", "hidden")
] = 4
PLACES_FINE: Annotated[int, Means("places", "between which a way to a flank is looked up", "hidden")] = 81
MOST_OF_PLAY: Annotated[
    float, Means("of a play", "that a way from its middle must leave, less than all of it", "hidden")
] = 0.9
UNKNOWN_WIDTH: Annotated[
    float, Means("natural logarithm", "a width that may lie so far off is stated from the middle", "hidden")
] = 0.1
AS_GOOD: Annotated[
    float, Means("of what is left", "two fits that differ by less explain the data as well", "hidden")
] = 0.02
WIDTH_GRID: Annotated[
    tuple[float, ...], Means("factor", "widths that are tried around what a probe of a play says", "width")
] = (0.15, 0.2, 0.25, 0.33, 0.42, 0.53, 0.67, 0.83, 1.0, 1.2, 1.5, 1.9, 2.4, 3.0, 4.0, 5.0, 7.0)
WIDTH_FINE: Annotated[
    float, Means("natural logarithm", "how well the likeliest width is looked for", "width")
] = 2e-3
WINDOW_OF_ERRORS_S: Annotated[
    float, Means("s", "of errors that say together whether a width is right there", "width")
] = 0.25
PUSH: Annotated[
    float,
    Means("of the largest torque", "a torque that is so far off shows where motion is chaotic", "predicted"),
] = 1e-3
PARTED_S: Annotated[float, Means("s", "of recording that says how far two simulations part", "predicted")] = (
    0.25
)
CHAOTIC: Annotated[
    float,
    Means(
        "times what it does to the plain model",
        "where the motion is moved more it is chaotic: a play of 0.02 rad moves it 1 to 50 times as much "
        "where it forgets, a thousand times where it does not",
        "predicted",
    ),
] = 60.0
MUCH_APART: Annotated[
    float,
    Means(
        "times what it does to the plain model",
        "where anything is chaotic, errors count only where the motion is moved less",
        "predicted",
    ),
] = 15.0
SOMEWHAT_APART: Annotated[
    float,
    Means(
        "times what it does to the plain model",
        "a motion that is moved so far, and explained so badly, is chaotic",
        "predicted",
    ),
] = 5.0
MOST_APART: Annotated[
    float,
    Means("noise levels", "how an axle began in its play is not forgotten where it shows more", "predicted"),
] = 1.0
UNPREDICTED: Annotated[
    float, Means("of the recordings", "less of it is borne: all is judged", "predicted")
] = 0.01
MOST_OF_ERROR: Annotated[
    float,
    Means(
        "of what a fit leaves",
        "lies where the motion is chaotic: that is not judged, be it ever so short",
        "predicted",
    ),
] = 0.5
TRIMMED_SHARE: Annotated[
    float, Means("of the recordings", "that are explained best say what a model's numbers are", "predicted")
] = 0.5
TRIMMED_S: Annotated[float, Means("s", "of recording that is explained well or badly", "predicted")] = 0.5
AFTERMATH: Annotated[
    float,
    Means(
        "times the middling error",
        "what is left after chaotic motion is its aftermath: it came out of it another way",
        "predicted",
    ),
] = 10.0
PREDICTED_LEAVES: Annotated[
    float,
    Means(
        "times the error of a reading",
        "is left where numbers that half of it agrees with predict the motion: else all is judged",
        "predicted",
    ),
] = 0.1
MORE_PREDICTED: Annotated[
    float, Means("of all blocks", "that the law named predicts beyond the first: it is fitted anew", "blind")
] = 0.01
FALSE_MINIMUM: Annotated[
    float,
    Means(
        "noise powers",
        "a play that leaves less may be in a false minimum: more lacks another effect",
        "hopping",
    ),
] = 5.0
HOPS: Annotated[int, Means("fits", "from near the one that is stated, of a play", "blind")] = 30
HOPS_IN_VAIN: Annotated[
    int, Means("fits", "in a row that find nothing clearly lower: then it is the lowest", "hopping")
] = 10
HOPPING_S: Annotated[float, Means("s", "of processor time that these fits may take together", "blind")] = 45.0
HOP_SIZES: Annotated[
    tuple[float, float], Means("natural logarithm", "by which numbers are moved, standard deviation", "blind")
] = (5e-5, 2e-3)
HOLLOWS: Annotated[
    float,
    Means("of the least squared error", "hollows as deep say how well numbers are known", "blind"),
] = 1.05
LEAST_PREDICTED: Annotated[
    float, Means("of the recordings", "must be predicted: of less nothing is concluded", "predicted")
] = 0.4
PREDICTED_ROUNDS: Annotated[
    int, Means("times", "an effect is fitted and what it predicts looked for anew", "predicted")
] = 5
PREDICTED_SAME: Annotated[
    float, Means("natural logarithm, or number", "the last round moves every number less", "predicted")
] = 3e-3
OTHER_SIZES: Annotated[
    tuple[float, ...],
    Means("factor", "sizes of an abrupt effect that are fitted from: it has false minima", "hidden"),
] = (0.75, 1.0, 1.3)
IN_VAIN: Annotated[
    float,
    Means("of the error beyond noise", "friction or play beside them that leaves more is given up", "race"),
] = 0.97
FREED_SIZES: Annotated[
    tuple[float, ...],
    Means("factor", "the same once the base model's numbers are free: wrong ones bent the size", "race"),
] = (0.35, 0.6, 1.0)
RACE: Annotated[int, Means("effects", "are fitted at each step", "hidden")] = 5
PROMISING: Annotated[float, Means("of the best score", "effects below it are not fitted", "hidden")] = 0.4
RACE_ROUNDS: Annotated[int, Means("rounds", "after which the hopeless are given up", "hidden")] = 3
STILL_FALLS: Annotated[
    float,
    Means(
        "of the total",
        "a fit that gets below it in as many rounds is fitted on, far from the noise",
        "race",
    ),
] = 0.5
OUT_OF_RACE: Annotated[
    float,
    Means(
        "times what the best leaves", "effects that leave more after the first rounds are hopeless", "hidden"
    ),
] = 2.5
OPTIONAL_LEAVES: Annotated[
    float, Means("of the remaining gap", "an optional number must leave less", "hidden")
] = 0.8
FORM_LEAVES: Annotated[
    float, Means("of the remaining gap", "the law of another author must leave less", "hidden")
] = 0.5
FORM_FROM: Annotated[
    float,
    Means("of the whole gap", "an effect that closes less lacks another one, not another law", "blind"),
] = 0.85
FORM_HOPE: Annotated[
    float,
    Means("times what the usual law leaves", "a law that leaves more after these rounds is not it", "blind"),
] = 1.2
FORM_FIRST: Annotated[int, Means("rounds", "after which a law is given up that is far behind", "laws")] = 2
FORM_HOPELESS: Annotated[
    float, Means("times what the usual law leaves", "a law that leaves more then is far behind", "laws")
] = 5.0
FORM_ROUNDS: Annotated[
    int, Means("rounds", "after which one other author's law goes on, the one that leaves least", "laws")
] = 5
UNKNOWN_SIGMAS: Annotated[
    float, Means("standard errors", "an optional number nearer to its default is closed again", "laws")
] = 3.0
LITTLE_GAINED: Annotated[
    float,
    Means("of the error beyond noise", "the last step of a fit that is one of many gains less", "laws"),
] = 1e-3
WORTH_POLISH: Annotated[
    float,
    Means("of the whole gap", "an abrupt effect that closes less is not fitted from other sizes", "hidden"),
] = 0.3
RACE_SLACK: Annotated[
    float,
    Means(
        "squared error, noise variances", "that an effect may leave besides before it is hopeless", "hidden"
    ),
] = 1000.0
RELATIVE_PROMISES: Annotated[
    float,
    Means("of the best score", "a relative of a promising effect must promise it to be fitted", "hidden"),
] = 0.1

LARGEST_ORDER: Annotated[dict[str, float], Means("orders", "looked for", "orders")] = {
    "wheel": 60.0,
    "motor": 60.0,
}
LEAST_ORDER: Annotated[
    float, Means("orders", "what turns with a shaft repeats with every turn", "orders")
] = 0.5
BINS_A_TURN: Annotated[int, Means("bins", "a turn of the largest order is sorted into", "orders")] = 8
FROM_HZ: Annotated[float, Means("Hz", "ripples slower than this are drift", "orders")] = 0.5
LEAST_ANGLE_RAD: Annotated[float, Means("rad", "an axle that turns less shows no order", "orders")] = 20.0
SPEED_BINS: Annotated[int, Means("bins", "of speed, in what an order is expected to bring", "orders")] = 200
ORDER_GRID: Annotated[int, Means("orders", "at which that is computed", "orders")] = 600

ROUNDING_MARGIN: Annotated[
    float, Means("factor", "rounding may leave so much more than its simulation says", "quantization")
] = 2.0

SCORED_MISMATCH: Annotated[
    float, Means("natural logarithm", "how far a wrong parameter's score may reach linearly", "screen")
] = 0.5
LOOKED_AT_CLOSELY: Annotated[
    float,
    Means(
        "of the best score",
        "an effect whose first sizes promise more is looked at closely; five times as much was found there",
        "screen",
    ),
] = 0.05
PROBE_DIVERGED: Annotated[
    float, Means("noise levels", "a larger response is a diverged probe and scores nothing", "screen")
] = 1e8

FAR_BETTER: Annotated[
    float, Means("of the remaining gap", "a base identified anew must leave less to be preferred", "far")
] = 0.5
COMES_NEAR: Annotated[
    float,
    Means(
        "times what the best effect beside other numbers leaves",
        "an effect that was found beside the given ones must leave less to be looked at there anew",
        "blind",
    ),
] = 1.5
FAR_MOVED: Annotated[
    float, Means("natural logarithm", "a parameter that moves further was far off", "far")
] = 0.1
FAR_SHARE: Annotated[
    float, Means("of the free parameters", "so many far off make a model far from the data", "far")
] = 0.4
FAR_SIGMAS: Annotated[
    float, Means("standard errors", "a parameter that moved by less did not move", "far")
] = 3.0
HOPELESS_GAP: Annotated[
    float, Means("gap over noise floor", "above it no effect alone may promise enough: numbers first", "far")
] = 5.0
HOPELESS_PROMISE: Annotated[
    float, Means("of the gap", "an effect that promises more is looked for before numbers are", "far")
] = 0.65
NUMBERS_LEAVE: Annotated[float, Means("of the gap", "numbers that leave less explain most", "far")] = 0.2
ALONE: Annotated[
    float,
    Means("of what free numbers leave", "friction or contact that explains more, and alone, is named", "far"),
] = 0.3
HALF_AS_GOOD: Annotated[
    float, Means("of its share", "another effect that explains less is no rival then", "far")
] = 0.5
MOST_EFFECTS: Annotated[int, Means("names", "at most", "blind")] = 3
LEAST_SHARE: Annotated[float, Means("of the remaining gap", "a further effect must close it", "blind")] = 0.6
LEAST_SHARE_OF_REST: Annotated[
    float, Means("of the remaining gap", "the same, once nearly all is closed", "blind")
] = 0.88
PARENTS: Annotated[tuple[int, ...], Means("hypotheses", "are grown to one, two, three effects", "blind")] = (
    1,
    3,
    2,
)
LEAST_SO_FAR: Annotated[
    tuple[float, ...],
    Means("of the gap", "is closed before a first, second, third effect is looked for", "blind"),
] = (0.0, 0.2, 0.6)
RIVAL: Annotated[
    float, Means("times what the best leaves", "a rival that leaves less is grown further as well", "blind")
] = 1.5

SLOW_NOISE: Annotated[
    float,
    Means(
        "factor of power", "a speed's noise at low frequency over that above all modes, at most", "tracking"
    ),
] = 4.0
WINDOW_S: Annotated[
    float, Means("s", "of recording that says of each phase how well it fits", "tracking")
] = 0.1
WALK_S: Annotated[
    float, Means("s", "of a speed's errors that may know of each other, as an angle walks", "wandering")
] = 1.0
PHASES: Annotated[int, Means("phases", "on a turn", "tracking")] = 72
REFINED: Annotated[int, Means("steps", "off the grid of phases", "tracking")] = 5
LEAST_STEP: Annotated[
    float, Means("rad of phase in a second", "an order may be a little off as well", "tracking")
] = 0.05
KNOWN_STEP: Annotated[
    float, Means("rad of phase in a second", "the same of an order that the model knows", "tracking")
] = 0.0005
START_RAD: Annotated[
    float, Means("rad", "how well the phase at the start is known once the ripple is", "tracking")
] = 0.3
SOON_S: Annotated[
    float, Means("s", "recordings that turn a ripple sooner say the same of its phase", "tracking")
] = 1.0
NO_RIPPLE: Annotated[float, Means("N m", "stands for no ripple", "tracking")] = 1e-9
RIPPLE_DIVERGED: Annotated[
    float,
    Means("noise levels", "a larger response is a diverged ripple and says nothing of a phase", "tracking"),
] = 1e9
