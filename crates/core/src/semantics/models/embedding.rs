//! Embedding: a text as a vector of a language model, whose angle to another tells how near the two are in meaning.
//!
//! Components are whole numbers, so that the same two vectors have the same cosine on every machine.

/// Fewest components of a vector; no model has so few.
const COMPONENTS_MIN: usize = 8;

/// Most components of a vector: twice those of the largest models in use.
const COMPONENTS_MAX: usize = 8192;

/// A text's vector, scaled so that its largest component is 127 or -127.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Embedding {
    components: Box<[i8]>,
    squared_length: i64,
}

impl Embedding {
    /// Rounds a vector as a model gives it; `None` if it has too few or too many components, is zero, or is not finite.
    pub fn round(vector: &[f64]) -> Option<Self> {
        let largest = vector.iter().fold(0.0_f64, |largest, component| largest.max(component.abs()));
        if !(largest > 0.0 && vector.iter().all(|component| component.is_finite())) {
            return None;
        }
        let scaled = vector.iter().map(|component| (component / largest * f64::from(i8::MAX)).round() as i8);
        Self::from_components(scaled.collect())
    }

    /// Takes components that were rounded before; `None` if they cannot have been.
    pub fn from_components(components: Box<[i8]>) -> Option<Self> {
        if !(COMPONENTS_MIN..=COMPONENTS_MAX).contains(&components.len()) {
            return None;
        }
        let squared_length = dot(&components, &components);
        (squared_length > 0).then_some(Self { components, squared_length })
    }

    /// Returns the components.
    pub fn components(&self) -> &[i8] {
        &self.components
    }

    /// Returns the cosine of the angle between two vectors, in [-1, 1]; `None` if two models made them.
    pub fn cosine(&self, other: &Self) -> Option<f64> {
        if self.components.len() != other.components.len() {
            return None;
        }
        let lengths = (self.squared_length as f64 * other.squared_length as f64).sqrt();
        Some(dot(&self.components, &other.components) as f64 / lengths)
    }
}

fn dot(a: &[i8], b: &[i8]) -> i64 {
    // 8,192 products of two bytes fit into 32 bits.
    let sum: i32 = a.iter().zip(b).map(|(a, b)| i32::from(*a) * i32::from(*b)).sum();
    i64::from(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_are_those_of_the_vectors() {
        let [mut x, mut y] = [[0.0; 8]; 2];
        x[0] = 0.02;
        (y[0], y[1]) = (3.0, 3.0);
        let [x, y] = [x, y].map(|vector| Embedding::round(&vector).expect("a vector"));
        assert_eq!(x.components()[..2], [127, 0]);
        assert_eq!(x.cosine(&x), Some(1.0));
        assert!((x.cosine(&y).expect("of one model") - 0.5_f64.sqrt()).abs() < 1e-12);
        let longer = Embedding::round(&[1.0; 9]).expect("a vector");
        assert_eq!(x.cosine(&longer), None);
    }

    #[test]
    fn rejects_answers_that_are_not_vectors() {
        for vector in [vec![], vec![1.0; 7], vec![0.0; 8], vec![f64::NAN; 8], vec![1.0; 8193]] {
            assert_eq!(Embedding::round(&vector), None, "{} components", vector.len());
        }
        let mut infinite = [1.0; 8];
        infinite[3] = f64::INFINITY;
        assert_eq!(Embedding::round(&infinite), None);
        assert_eq!(Embedding::from_components([0; 8].into()), None);
        assert!(Embedding::round(&vec![1.0; COMPONENTS_MAX]).is_some());
    }
}
