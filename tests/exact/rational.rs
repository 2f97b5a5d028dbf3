//! Polynomials and B-splines in exact rational arithmetic, straight from their definitions.

use num_rational::BigRational;
use num_traits::{One, Zero};

pub(super) type Q = BigRational;

/// numerator/denominator.
pub(super) fn q(numerator: i64, denominator: i64) -> Q {
    Q::new(numerator.into(), denominator.into())
}

/// A decimal as it is printed, exponent and leading sign included.
pub(super) fn decimal(text: &str) -> Option<Q> {
    let (mantissa, exponent) = match text.split_once('E') {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let unsigned = mantissa.trim_start_matches(['+', '-']);
    let (whole, fraction) = unsigned.split_once('.').unwrap_or((unsigned, ""));
    let digits = format!("{whole}{fraction}");
    let units = Q::from_integer(digits.parse().ok()?);
    let shift = exponent - fraction.len() as i32;
    let power = num_traits::pow(q(10, 1), shift.unsigned_abs() as usize);
    let value = if shift < 0 { units / power } else { units * power };
    Some(if mantissa.starts_with('-') { -value } else { value })
}

/// How many decimals a printed number has.
pub(super) fn decimals(text: &str) -> usize {
    text.split_once('.').map_or(0, |(_, fraction)| fraction.len())
}

pub(super) fn abs(x: &Q) -> Q {
    if *x < Q::zero() { -x.clone() } else { x.clone() }
}

/// A polynomial in powers of s, 0 ≤ s ≤ 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Poly(pub(super) Vec<Q>);

impl Poly {
    pub(super) fn at(&self, s: &Q) -> Q {
        self.0.iter().rev().fold(Q::zero(), |sum, a| sum * s + a)
    }

    pub(super) fn coefficient(&self, k: usize) -> Q {
        self.0.get(k).cloned().unwrap_or_else(Q::zero)
    }

    pub(super) fn plus(&self, other: &Poly) -> Poly {
        Poly(
            (0..self.0.len().max(other.0.len()))
                .map(|k| self.coefficient(k) + other.coefficient(k))
                .collect(),
        )
    }

    pub(super) fn times(&self, other: &Poly) -> Poly {
        let mut product = vec![Q::zero(); (self.0.len() + other.0.len()).max(2) - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Poly(product)
    }

    pub(super) fn scaled(&self, factor: &Q) -> Poly {
        Poly(self.0.iter().map(|a| a * factor).collect())
    }

    /// The greatest Bernstein coefficient of |f| on the parts between k/parts and (k+1)/parts: a bound on it.
    pub(super) fn bound(&self, parts: i64) -> Q {
        let n = self.0.len() - 1;
        let mut most = Q::zero();
        for part in 0..parts {
            // f(part/parts + s/parts) in powers of s, then Bernstein coefficients Σ C(i,k)/C(n,k) a_k.
            let mut shifted = vec![Q::zero(); n + 1];
            let line = Poly(vec![q(part, parts), q(1, parts)]);
            let mut power = Poly(vec![Q::one()]);
            for a in &self.0 {
                for (to, x) in shifted.iter_mut().zip(&power.0) {
                    *to += a * x;
                }
                power = power.times(&line);
            }
            for i in 0..=n {
                let value =
                    (0..=i).fold(Q::zero(), |sum, k| sum + q(binomial(i, k), binomial(n, k)) * &shifted[k]);
                most = most.max(abs(&value));
            }
        }
        most
    }
}

fn binomial(n: usize, k: usize) -> i64 {
    (0..k).fold(1, |c, j| c * (n - j) as i64 / (j + 1) as i64)
}

/// One span: a numerator for each coordinate over one denominator.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub(super) numerators: Vec<Poly>,
    pub(super) denominator: Poly,
}

impl Span {
    pub(super) fn at(&self, s: &Q) -> Vec<Q> {
        let d = self.denominator.at(s);
        self.numerators.iter().map(|n| n.at(s) / &d).collect()
    }
}

/// The spans of positive length of a B-spline, by the recursion of Cox and de Boor in polynomials of the span's own s.
pub(super) fn spans(degree: usize, knots: &[Q], points: &[Vec<Q>], weights: &[Q]) -> Vec<Span> {
    let (p, n) = (degree, points.len());
    (p..n)
        .filter(|&j| knots[j] < knots[j + 1])
        .map(|j| {
            let h = &knots[j + 1] - &knots[j];
            // (t − t_i)/(t_{i+k} − t_i) with t = t_j + h s, or 0 where the knots are one.
            let ramp = |i: usize, k: usize| {
                let width = &knots[i + k] - &knots[i];
                if width.is_zero() {
                    return None;
                }
                Some(Poly(vec![(&knots[j] - &knots[i]) / &width, &h / &width]))
            };
            let mut basis: Vec<Poly> =
                (0..knots.len() - 1).map(|i| Poly(vec![if i == j { Q::one() } else { Q::zero() }])).collect();
            for k in 1..=p {
                basis = (0..basis.len() - 1)
                    .map(|i| {
                        let rising = ramp(i, k).map_or(Poly(vec![Q::zero()]), |r| r.times(&basis[i]));
                        let falling = ramp(i + 1, k).map_or(Poly(vec![Q::zero()]), |r| {
                            Poly(vec![Q::one()]).plus(&r.scaled(&-Q::one())).times(&basis[i + 1])
                        });
                        rising.plus(&falling)
                    })
                    .collect();
            }
            let zero = || Poly(vec![Q::zero()]);
            let sum =
                |of: &dyn Fn(usize) -> Q| (0..n).fold(zero(), |sum, i| sum.plus(&basis[i].scaled(&of(i))));
            let axes = points[0].len();
            Span {
                numerators: (0..axes).map(|axis| sum(&|i| &weights[i] * &points[i][axis])).collect(),
                denominator: sum(&|i| weights[i].clone()),
            }
        })
        .collect()
}
