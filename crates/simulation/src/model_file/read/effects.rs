//! `[[effect]]`: physics added to the model.

use super::components::Words;
use super::*;
use crate::effect::{EffectSpec, PROVENANCE};
use crate::effects::EffectParams;

impl ModelReader<'_> {
    pub(super) fn effects(&mut self) -> Vec<EffectSpec> {
        let items = self.items("effect");
        items.into_iter().filter_map(|tree| self.effect(tree)).collect()
    }

    fn effect(&mut self, tree: Tree) -> Option<EffectSpec> {
        let mut words = Words::new("effect".to_owned(), tree);
        let kind = self.word_of::<EffectParams>(&mut words, "id")?;
        words.what = format!("effect {kind}");
        let component = self.required_text(&mut words, "component")?;
        words.what = format!("effect {kind} of \"{component}\"");
        let mut provenance = serde_json::Map::new();
        for field in PROVENANCE {
            words.asked.push(field);
            if let Some((key, value)) = words.tree.take(field) {
                provenance.insert(key.name.into(), value.to_json());
            }
        }
        let (params, place) = self.parameters(words, &kind)?;
        Some(EffectSpec { component, params, provenance, place })
    }
}
