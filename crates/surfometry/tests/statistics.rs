//! Statistics against published worked examples and certified values.

use surfometry::statistics::{
    Agreement, Bootstrap, ConfusionMatrix, Estimate, EulerRounding, PairError, Paired, bland_altman,
    bootstrap, concordance, intraclass, least_squares,
};

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

/// Norris, NIST Statistical Reference Datasets (linear regression, lower level of difficulty): certified
/// values.
#[test]
fn least_squares_of_norris() {
    let y = [
        0.1, 338.8, 118.1, 888.0, 9.2, 228.1, 668.5, 998.5, 449.1, 778.9, 559.2, 0.3, 0.1, 778.1, 668.8,
        339.3, 448.9, 10.8, 557.7, 228.3, 998.0, 888.8, 119.6, 0.3, 0.6, 557.6, 339.3, 888.0, 998.5, 778.9,
        10.2, 117.6, 228.9, 668.4, 449.2, 0.2,
    ];
    let x = [
        0.2, 337.4, 118.2, 884.6, 10.1, 226.5, 666.3, 996.3, 448.6, 777.0, 558.2, 0.4, 0.6, 775.5, 666.9,
        338.0, 447.5, 11.6, 556.0, 228.1, 995.8, 887.6, 120.2, 0.3, 0.3, 556.8, 339.1, 887.2, 999.0, 779.0,
        11.1, 118.3, 229.2, 669.1, 448.9, 0.5,
    ];
    let fit = least_squares(&x, &y);
    close(fit.slope.value, 1.002_116_818_020_45, 1e-12);
    close(fit.intercept.value, -0.262_323_073_774_029, 1e-10);
    close(fit.r_squared, 0.999_993_745_883_712, 1e-12);
    close(fit.residual_deviation, 0.884_796_396_144_373, 1e-10);
    // Certified standard deviations times t(0.975, 34).
    let half = |e: Estimate| 0.5 * (e.interval[1] - e.interval[0]);
    close(half(fit.slope), 2.032_244_509 * 0.000_429_796_848_199_937, 1e-10);
    close(half(fit.intercept), 2.032_244_509 * 0.232_818_234_301_152, 1e-7);
    assert!(fit.slope_p_value < 1e-60);
}

/// Peak expiratory flow by a large and a mini Wright meter, first readings (Bland and Altman, Lancet 1986).
fn flow_meters() -> Paired {
    let large =
        [494, 395, 516, 434, 476, 557, 413, 442, 650, 433, 417, 656, 267, 478, 178, 423, 427].map(f64::from);
    let mini =
        [512, 430, 520, 428, 500, 600, 364, 380, 658, 445, 432, 626, 260, 477, 259, 350, 451].map(f64::from);
    Paired::new(large.to_vec(), mini.to_vec()).unwrap()
}

/// The paper: mean difference -2.1 (95 % interval -22.0 to 17.8), standard deviation 38.8, r = 0.94. Limits
/// there have 2 standard deviations and a rougher error, 16.3, of each limit (-114.3 to -45.1 and 40.9 to
/// 110.1).
#[test]
fn flow_meters_of_bland_and_altman() {
    let pairs = flow_meters();
    let result = bland_altman(&pairs);
    close(result.bias.value, -2.1, 0.05);
    close(result.bias.interval[0], -22.0, 0.1);
    close(result.bias.interval[1], 17.8, 0.1);
    close(result.deviation, 38.8, 0.05);
    let [low, high] = result.limits;
    close(low.value, -2.118 - 1.96 * 38.765, 0.02);
    close(high.value, -2.118 + 1.96 * 38.765, 0.02);
    close(0.5 * (high.interval[1] - high.interval[0]), 34.6, 1.0);
    close(result.limits_width_percent, 100.0 * 3.92 * 38.765 / 451.2, 0.2);
    // r of 0.94, so R^2 of 0.89; no proportional bias worth the name.
    close(least_squares(pairs.standard(), pairs.method()).r_squared, 0.89, 0.005);
    assert!(result.proportional.slope_p_value > 0.2 && result.bias_p_value > 0.8);
}

/// SciPy: linregress and ttest_rel on differences that grow with size by construction; the sign is the
/// method's.
#[test]
fn proportional_bias_is_the_slope_and_the_limits_width_is_not() {
    let standard: Vec<f64> = (0..40).map(|n| 100.0 + f64::from(n)).collect();
    let wave = |n: usize| 0.3 * (n as f64 * 2.4).sin();
    let method: Vec<f64> = standard.iter().enumerate().map(|(n, s)| 1.05 * s + wave(n)).collect();
    let result = bland_altman(&Paired::new(method, standard).unwrap());
    assert!(result.bias.value > 0.0);
    // d = 0.05 s and m = 1.025 s.
    close(result.proportional.slope.value, 0.05 / 1.025, 1e-3);
    assert!(result.proportional.slope_p_value < 1e-15);
    close(result.bias_percent, 5.0, 0.05);
    assert!((result.limits_width_percent - 5.0).abs() > 1.0);
}

/// The six targets and four judges of Shrout and Fleiss (1979): 0.29 and 0.71; intervals as R's `psych::ICC`
/// gives them.
#[test]
fn judges_of_shrout_and_fleiss() {
    let judges: [[f64; 6]; 4] = [
        [9.0, 6.0, 8.0, 7.0, 10.0, 6.0],
        [2.0, 1.0, 4.0, 1.0, 5.0, 2.0],
        [5.0, 3.0, 6.0, 2.0, 6.0, 4.0],
        [8.0, 2.0, 8.0, 6.0, 9.0, 7.0],
    ];
    let judges: Vec<&[f64]> = judges.iter().map(<[f64; 6]>::as_slice).collect();
    let result = intraclass(&judges);
    close(result.agreement.value, 0.29, 0.005);
    close(result.agreement.interval[0], 0.019, 0.001);
    close(result.agreement.interval[1], 0.76, 0.005);
    close(result.consistency.value, 0.71, 0.006);
    close(result.consistency.interval[0], 0.34, 0.006);
    close(result.consistency.interval[1], 0.95, 0.006);
}

/// Concordance is correlation where neither mean nor spread differs, is lowered by a shift as its definition
/// says, and its interval is that of the correlation (Fisher's, sqrt(n - 2) for sqrt(n - 3)) without a shift.
#[test]
fn concordance_by_its_definition() {
    let pairs = flow_meters();
    let (x, y) = (pairs.method(), pairs.standard());
    let n = x.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let moment =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / n - mean(a) * mean(b);
    let expected = 2.0 * moment(x, y) / (moment(x, x) + moment(y, y) + (mean(x) - mean(y)).powi(2));
    let found = concordance(&pairs);
    close(found.value, expected, 1e-12);
    assert!(found.interval[0] > 0.8 && found.interval[1] < 0.99 && found.interval[0] < found.value);
    // Same spread, no shift: Fisher's interval about r.
    let turned: Vec<f64> = (0..30).map(|k| (f64::from(k) * 0.9).cos()).collect();
    let base: Vec<f64> = (0..30).map(|k| (f64::from(k) * 0.9 + 0.4).cos()).collect();
    let fisher = concordance(&Paired::new(turned, base).unwrap());
    let half = 1.96 / 28f64.sqrt();
    close(fisher.value.atanh() - fisher.interval[0].atanh(), half, 0.02 * half);
    let same = Paired::new(vec![1.0, 2.0, 4.0], vec![1.0, 2.0, 4.0]).unwrap();
    assert_eq!(concordance(&same).interval, [1.0; 2]);
}

/// Of a mean, the bootstrap's interval is Student's, nearly; the same seed gives the same bits, another seed
/// nearly the same. Its coverage is what it says.
#[test]
fn bootstrapped_intervals() {
    let pairs = flow_meters();
    let mean = |p: &Paired| p.differences().iter().sum::<f64>() / p.count() as f64;
    let of = |seed| bootstrap(&pairs, Bootstrap { samples: 4000, seed }, mean).unwrap();
    assert_eq!(of(1), of(1));
    let student = bland_altman(&pairs).bias;
    for (a, b) in of(1).interval.into_iter().zip(of(2).interval) {
        assert!((a - b).abs() < 2.0, "{a} {b}");
    }
    for (a, b) in of(1).interval.into_iter().zip(student.interval) {
        assert!((a - b).abs() < 4.0, "{a} {b}");
    }
    // Differences of a known mean, skewed: 200 samples of 25.
    let covered = (0..200)
        .filter(|sample| {
            let value = |n: i32| {
                let place = (f64::from(sample * 25 + n + 1) * 0.618_033_988_749_895).fract();
                -(1.0 - place).ln()
            };
            let method: Vec<f64> = (0..25).map(value).collect();
            let standard: Vec<f64> = (0..25).map(|n| 1e-9 * f64::from(n)).collect();
            let pairs = Paired::new(method, standard).unwrap();
            let [low, high] = bootstrap(&pairs, Bootstrap { samples: 400, seed: 7 }, mean).unwrap().interval;
            low < 1.0 && high > 1.0
        })
        .count();
    assert!(covered > 180, "{covered} of 200");
}

/// A table may hold any number: what is beyond 64 bits is the largest class (found by `experiments/hostile`).
#[test]
fn characteristics_beyond_64_bits() {
    for (chi, class) in [(1e300, i64::MAX), (-1e300, i64::MIN), (f64::MAX, i64::MAX), (9.3e18, i64::MAX)] {
        for rounding in [EulerRounding::Even, EulerRounding::Integer] {
            assert_eq!(
                ConfusionMatrix::new(&[(chi, 2.0)], rounding).classes,
                if class > 2 { [2, class] } else { [class, 2] }
            );
        }
    }
}

#[test]
fn characteristics_are_even() {
    let pairs = [(0.04, 0.0), (1.94, 2.0), (-0.9, 0.0), (0.6, 0.0), (-1.1, -2.0)];
    let even = ConfusionMatrix::new(&pairs, EulerRounding::Even);
    assert_eq!(even.classes, [-2, 0, 2]);
    assert_eq!(even.counts, [vec![1, 0, 0], vec![0, 3, 0], vec![0, 0, 1]]);
    assert_eq!(even.accuracy(), 1.0);
    let whole = ConfusionMatrix::new(&pairs, EulerRounding::Integer);
    assert_eq!(whole.classes, [-2, -1, 0, 1, 2]);
    assert!((whole.accuracy() - 0.4).abs() < 1e-12);
}

/// Classes by the thousand: the frequent ones are listed, the rest is counted.
#[test]
fn rare_characteristics_are_counted() {
    // 0 by both in 40 pairs, 1 to 3000 once each by both, and by the method alone 4000 in two pairs.
    let mut pairs = vec![(0.0, 0.0); 40];
    pairs.extend((1..=3000).map(|n| (2.0 * f64::from(n), 2.0 * f64::from(n))));
    pairs.extend([(8000.0, 0.0); 2]);
    let matrix = ConfusionMatrix::new(&pairs, EulerRounding::Even);
    assert_eq!((matrix.classes.len(), matrix.counts.len()), (50, 50));
    // Of the equally frequent ones the least, and among them 8000, twice by the method as 2 is once by both.
    assert_eq!(matrix.classes[..3], [0, 2, 4]);
    assert_eq!(*matrix.classes.last().unwrap(), 98);
    assert_eq!((matrix.counts[0][0], matrix.counts[1][1]), (40, 1));
    let rare = matrix.rare.unwrap();
    assert_eq!((rare.classes, rare.pairs, rare.same), (2952, 2953, 2951));
    assert_eq!(matrix.accuracy(), 3040.0 / 3042.0);
    let few = ConfusionMatrix::new(&pairs[..89], EulerRounding::Even);
    assert_eq!((few.classes.len(), few.rare), (50, None));
}

/// A million pairs of a known law: y = 1.01 x + noise of deviation 3, x uniform on 0 to 1000.
#[test]
fn a_million_pairs() {
    let place = |n: u32, step: f64| (f64::from(n) * step).fract();
    let standard: Vec<f64> = (0..1_000_000).map(|n| 1000.0 * place(n, 0.618_033_988_749_895)).collect();
    let noise = |n: u32| 3.0 * 12f64.sqrt() * (place(n, std::f64::consts::SQRT_2) - 0.5);
    let method = standard.iter().zip(0..).map(|(s, n)| 1.01 * s + noise(n)).collect();
    let result = Agreement::of(&Paired::new(method, standard).unwrap(), Bootstrap::default());
    close(result.regression.slope.value, 1.01, 1e-4);
    close(result.bland_altman.bias.value, 5.0, 0.01);
    // Consistency is 2 cov / (both variances): 2.02 / (1 + 1.0201 + 9 / 83,333).
    let consistency = result.intraclass.consistency;
    close(consistency.value, 2.02 / (2.0201 + 9.0 / 83_333.33), 1e-5);
    let [low, high] = consistency.interval;
    assert!(low < consistency.value && consistency.value < high && high - low < 1e-5, "{low} {high}");
    let [low, high] = result.intraclass.agreement.interval;
    assert!(low < result.intraclass.agreement.value && result.intraclass.agreement.value < high);
    assert!(result.bootstrapped_bias.is_none(), "of so many none is drawn");
}

#[test]
fn what_cannot_be_compared() {
    assert_eq!(Paired::new(vec![1.0], vec![]).unwrap_err(), PairError::Unpaired { method: 1, standard: 0 });
    assert_eq!(Paired::new(vec![1.0, 2.0], vec![1.0, 2.0]).unwrap_err(), PairError::TooFew(2));
    assert_eq!(
        Paired::new(vec![1.0, f64::NAN, 2.0], vec![1.0, 2.0, 3.0]).unwrap_err(),
        PairError::NotFinite(1)
    );
    // Of what does not vary there is a bias, -1, and a line only on what does.
    for (method, standard, slope) in
        [(vec![1.0; 3], vec![1.0, 2.0, 3.0], Some(0.0)), (vec![0.0, 1.0, 2.0], vec![2.0; 3], None)]
    {
        let result = Agreement::of(&Paired::new(method, standard).unwrap(), Bootstrap::default());
        close(result.bland_altman.bias.value, -1.0, 1e-12);
        assert!(result.concordance.value.is_nan() && result.bland_altman.proportional.slope.value.is_nan());
        assert_eq!(Some(result.regression.slope.value).filter(|slope| !slope.is_nan()), slope);
    }
}

/// A method that is the standard: slope 1, no bias, no NaN anywhere.
#[test]
fn identical_values() {
    let values = vec![3.0, 5.0, 9.0, 11.0];
    let result = Agreement::of(&Paired::new(values.clone(), values).unwrap(), Bootstrap::default());
    close(result.regression.slope.value, 1.0, 1e-12);
    assert_eq!(result.bland_altman.bias.value, 0.0);
    assert_eq!(result.bland_altman.bias_p_value, 1.0);
    assert_eq!(result.intraclass.agreement.value, 1.0);
    assert!(result.bootstrapped_bias.is_none());
    assert_eq!(result.bland_altman.proportional.slope_p_value, 1.0);
}
