"""`compare` against SciPy."""

import csv
import json

import numpy as np
from conftest import surfometry
from scipy import stats


def test_agreement_is_scipys(tmp_path):
    """Regression, paired t-test, slope of the differences, and the bootstrap's interval, of fifty objects."""
    chance = np.random.default_rng(3)
    standard = chance.lognormal(3, 0.3, 50)
    method = 1.03 * standard - 0.4 + chance.normal(0, 0.5, 50)
    for name, values in (("method", method), ("standard", standard)):
        with (tmp_path / f"{name}.csv").open("w") as file:
            rows = csv.writer(file)
            rows.writerow(["input", "label", "size"])
            rows.writerows([f"{n}.nii", 1, repr(float(v))] for n, v in enumerate(values))
    output = tmp_path / "all.json"
    surfometry("compare", tmp_path / "method.csv", tmp_path / "standard.csv", "--column", "size", "-o", output)
    found = json.loads(output.read_text())["measures"][0]["agreement"]
    close = lambda value, expected, relative=1e-9: np.testing.assert_allclose(value, expected, rtol=relative)

    line = stats.linregress(standard, method)
    quantile = stats.t.ppf(0.975, 48)
    slope, intercept = found["regression"]["slope"], found["regression"]["intercept"]
    close(slope["value"], line.slope)
    close(slope["interval"], [line.slope - quantile * line.stderr, line.slope + quantile * line.stderr])
    close(intercept["value"], line.intercept)
    close(intercept["interval"][1], line.intercept + quantile * line.intercept_stderr)
    close(found["regression"]["r_squared"], line.rvalue**2)

    difference = method - standard
    t_test = stats.ttest_rel(method, standard)
    bland_altman = found["bland_altman"]
    close(bland_altman["bias"]["value"], difference.mean())
    close(bland_altman["bias"]["interval"], list(t_test.confidence_interval()))
    close(bland_altman["bias_p_value"], t_test.pvalue, 1e-7)
    close(bland_altman["limits"][1]["value"], difference.mean() + 1.96 * difference.std(ddof=1))
    trend = stats.linregress(0.5 * (method + standard), difference)
    close(bland_altman["proportional"]["slope"]["value"], trend.slope)
    close(bland_altman["proportional"]["slope_p_value"], trend.pvalue, 1e-6)

    interval = stats.bootstrap((difference,), np.mean, method="BCa", n_resamples=20000, rng=1).confidence_interval
    width = interval.high - interval.low
    assert np.abs(np.array(found["bootstrapped_bias"]["interval"]) - interval).max() < 0.1 * width
    moments = np.cov(method, standard, ddof=0)
    concordance = 2 * moments[0, 1] / (moments[0, 0] + moments[1, 1] + difference.mean() ** 2)
    close(found["concordance"]["value"], concordance)
