//! Menus on things: by the right mouse button, or by Shift+F10 on what has the focus.

use egui::{Key, Modifiers, Popup, Response, Ui};

/// Shows a menu while it is open.
pub(super) fn on(response: &Response, content: impl FnOnce(&mut Ui)) {
    let (context, id) = (&response.ctx, Popup::default_response_id(response));
    if response.has_focus() && context.input_mut(|input| input.consume_key(Modifiers::SHIFT, Key::F10)) {
        context.data_mut(|data| data.insert_temp(id, true));
        Popup::open_id(context, id);
    }
    let by_key = context.data(|data| data.get_temp(id)).unwrap_or(false);
    let menu = Popup::context_menu(response);
    // There may be no pointer to open it at.
    let menu = if by_key { menu.at_position(response.rect.left_bottom()) } else { menu };
    menu.show(content);
    if by_key && !Popup::is_id_open(context, id) {
        context.data_mut(|data| data.remove::<bool>(id));
    }
}
