"""Ownership of contacts: the contacts of a body point belong either to one performer or to all performers of the
motion.
"""

from dataclasses import replace

from studio.core.constraints.scope import Scope
from studio.document.edited_project import EditedProject


def move_contact_to_scope(document: EditedProject, contact_id: str, scope: Scope, text: str) -> str:
    """Move a contact, with all contacts of its point, to another scope; returns the id of the contact there.

    Contacts of a single performer begin as copies of the shared ones, and are removed when it returns to the shared
    ones.
    """
    project = document.project
    contact = project.contacts[contact_id]
    beside = {
        key: each
        for key, each in project.contacts_of(contact.motion_id).items()
        if (each.point, each.scope) == (contact.point, contact.scope)
    }
    of_all = [
        key
        for key, each in project.contacts_of(contact.motion_id).items()
        if each.point == contact.point and not each.scope.is_narrow
    ]
    with document.group(text):
        if not contact.scope.is_narrow:
            ids = document.add_all("contacts", (replace(each, scope=scope) for each in beside.values()), text)
            return dict(zip(beside, ids, strict=True))[contact_id]
        if scope.is_narrow or not of_all:
            for key, each in beside.items():
                document.replace("contacts", key, replace(each, scope=scope), text)
            return contact_id
        for key in beside:
            document.remove("contacts", key, text)
    return min(of_all, key=lambda key: abs(project.contacts[key].first - contact.first))
