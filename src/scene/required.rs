//! Required keys of a scene and their expected values.

use serde::de::value::{MapDeserializer, SeqDeserializer};
use serde::de::{Deserialize, Deserializer, IntoDeserializer, Visitor};
use thiserror::Error;
use toml::{Table, Value};

use super::keys::{KEYS, Key, Need};
use super::{Invalid, Scene, units};
use crate::sentence::sentence;

/// Deserialisation error that distinguishes missing keys from all other errors.
#[derive(Debug, Error)]
enum Refusal {
    #[error("`{0}` is missing")]
    Missing(&'static str),
    #[error("{0}")]
    Other(String),
}

impl serde::de::Error for Refusal {
    fn custom<T: std::fmt::Display>(message: T) -> Self {
        Self::Other(message.to_string())
    }

    fn missing_field(field: &'static str) -> Self {
        Self::Missing(field)
    }
}

/// Value of a scene file, deserialised with [`Refusal`] as the error type.
struct Node(Value);

impl IntoDeserializer<'_, Refusal> for Node {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Node {
    type Error = Refusal;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        match self.0 {
            Value::String(text) => visitor.visit_string(text),
            Value::Integer(number) => visitor.visit_i64(number),
            Value::Float(number) => visitor.visit_f64(number),
            Value::Boolean(flag) => visitor.visit_bool(flag),
            Value::Datetime(time) => visitor.visit_string(time.to_string()),
            Value::Array(items) => visitor.visit_seq(SeqDeserializer::new(items.into_iter().map(Self))),
            Value::Table(table) => {
                visitor.visit_map(MapDeserializer::new(table.into_iter().map(|(key, value)| (key, Self(value)))))
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        visitor.visit_some(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refusal> {
        match self.0 {
            Value::String(text) => visitor.visit_enum(text.into_deserializer()),
            other => Self(other).deserialize_any(visitor),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf unit unit_struct newtype_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

/// Returns the missing key, if it is the first error in the scene.
pub(super) fn missing(table: Table) -> Option<Invalid> {
    let scene = Value::Table(table);
    let Err(Refusal::Missing(field)) = Scene::deserialize(Node(scene.clone())) else { return None };
    // The parser checks the keys of the scene itself last.
    let (outer, inner): (Vec<&Key>, Vec<&Key>) = KEYS.iter().partition(|key| !key.path.contains('.'));
    inner.into_iter().chain(outer).filter(|key| key.path.rsplit('.').next() == Some(field)).find_map(|key| {
        let Need::Required(description) = key.need else { return None };
        let parts: Vec<&str> = key.path.split('.').collect();
        let place = place_without(&scene, &parts)?;
        let expected = units::quantity_of(key.path).unwrap_or_else(|| description.into());
        Some(Invalid::new(place, sentence!("expected %{what}, got nothing", what = expected)))
    })
}

/// Returns the path, as in `--set`, of the first table that exists but lacks the key.
fn place_without(value: &Value, key: &[&str]) -> Option<String> {
    match (value, key) {
        (Value::Array(items), _) => {
            items.iter().enumerate().find_map(|(i, item)| Some(format!("{i}.{}", place_without(item, key)?)))
        }
        (Value::Table(table), [last]) => (!table.contains_key(*last)).then(|| (*last).to_owned()),
        (Value::Table(table), [first, rest @ ..]) => {
            Some(format!("{first}.{}", place_without(table.get(*first)?, rest)?))
        }
        _ => None,
    }
}
